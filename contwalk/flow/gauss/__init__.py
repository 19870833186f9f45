"""Orthogonal collocation at Gauss points: given steps, their exact derivatives, and error control."""
