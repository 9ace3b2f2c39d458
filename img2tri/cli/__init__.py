"""The command line, ``img2tri``, in the order of the flow.

    what was typed      -> arguments     arguments, mesh_options
    arguments           -> jobs          jobs        an image, and the files to be made of it
    a job               -> an outcome    mesh_job    by mesh_image, as any user of the library would
    jobs                -> outcomes      batch       one after the other, or by several processes
    outcomes            -> words         printing    the one place that prints

`app_command` starts the app; `streams` has stdin and stdout as files; `program` puts the parts together.
"""

from __future__ import annotations

from img2tri.cli.program import main

__all__ = ["main"]
