"""The command line, ``img2tri``, in the order of the flow.

    what was typed      -> arguments     arguments          the commands, and what they share
                                         option_arguments   options of meshing, from their entries in `img2tri.options`
                                         save_arguments     options of saving, and which formats take them
    arguments           -> jobs          file_names         an image, those of a folder or pattern too, and the files to be made of it
    a job               -> an outcome    meshing_job        by mesh_image, as any user of the library would
    jobs                -> outcomes      run_jobs           one after the other, or by the workers of `img2tri.many`
    outcomes            -> words         printing           the one place that prints
                                         summary_table      a row for each image, and which are whole already
                                         wording            messages in the words of the command line

`job` has the records these hand to each other, `stdin_stdout` has stdin and stdout as files; `commands` has ``img2tri tiles`` and
``img2tri app``; `program` puts the parts together.
"""

from __future__ import annotations

from img2tri.cli.program import main

__all__ = ["main"]
