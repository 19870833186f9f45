"""The run file: its form, what is read from it, and what is said where it is wrong."""
