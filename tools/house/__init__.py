"""What `make docs` draws and lists of the code: the picture of the layers, and the table of modules."""
