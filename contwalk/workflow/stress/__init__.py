"""A study again in other units, in another order of the states, and at other accuracies: is it the same?"""
