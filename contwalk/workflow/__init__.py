"""Run files in, databases and figures out: what each command does, without the command line."""
