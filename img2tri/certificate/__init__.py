"""What a finished mesh keeps of what was promised, measured on its triangles.

measures  What a certificate is made of: distances, areas, topology and defects of a mesh, measured on its triangles.
report    The certificate: what a finished mesh keeps of what was promised, in numbers.
"""
