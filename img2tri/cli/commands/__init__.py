"""Commands beside ``img2tri mesh`` that need more than a function of the program.

tiles_command   one image larger than memory, in parts, by several processes or on a Dask cluster
"""
