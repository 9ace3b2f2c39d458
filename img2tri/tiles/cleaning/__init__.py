"""Specks dropped, holes filled, largest components kept where components span blocks: the bits of the same in memory.

clean_blocks      the turns: what of each block is a graph, what becomes of its components, what is written down: the place to begin reading
component_graph   the components of a block, and how they go on beyond its border -> those of the whole, as a small graph
cleaned_labels    the labels of pixels that have changed, kept by block, laid over what windows read
"""
