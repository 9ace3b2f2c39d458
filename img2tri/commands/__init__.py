"""The parts of the command line.

In the order of the flow::

    what was typed      -> arguments     options, mesh_options
    arguments           -> jobs          jobs        an image, and the files to be made of it
    a job               -> an outcome    making      by mesh_image, as any user of the library would
    jobs                -> outcomes      batch       one after the other, or by several processes
    outcomes            -> words         telling     the one place that prints

`streams` has stdin and stdout as files. `img2tri.cli` puts the parts together.
"""
