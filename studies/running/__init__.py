"""What the studies run on: command lines, files, runs side by side, locks, pages and the list of studies.

`study.Study` is what a study is; `registry` finds them all; `command_line` and `files` are what every command shares.
"""
