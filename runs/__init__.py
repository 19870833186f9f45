"""Run files of the systems that come along: `contwalk examples` lists and copies them."""
