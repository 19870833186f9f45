"""What is wrong with a plugin: all of it, for `contwalk systems check`, and what is cheap, at every load."""
