"""Label map -> the edges between pixels of different labels, joined to chains.

chains       Cracks -> chains: the order in which the outlines run.
crack_edges  Label map -> cracks, and how they follow each other.
dual_edges   Chains of cracks, laid out in the plane: what the places of an outline's points may be.
"""
