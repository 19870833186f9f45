"""What breaks: kills, full disks, damaged and hostile files, two writers, numbers at their limits.

python -m tools.trial                          all of it, by a seed: `make trial`
python -m tools.trial --share 0.1 --seed 7     a tenth, as in `.ci/run`
python -m tools.trial --table                  and write the table of docs/trial.md
"""
