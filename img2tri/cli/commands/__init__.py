"""Commands beside ``img2tri mesh`` that need more than a function of the program.

app_command     a page in the browser to turn the knobs of a mesh
tiles_command   one image larger than memory, in parts, by several processes or on a Dask cluster
"""
