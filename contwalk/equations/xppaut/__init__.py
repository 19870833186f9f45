"""XPPAUT's .ode files, read as models."""
