"""SBML's levels 2 and 3, read by python-libsbml: reactions, rules, functions and events as equations."""
