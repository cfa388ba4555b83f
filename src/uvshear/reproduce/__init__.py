"""The tables and figures of Rivi & Miller 2018 as they are found with this package, beside those of the paper.

There is one file for each target, and ``registry`` knows them all. Nothing is imported before it is needed, so that the
command line can list the targets at once.
"""
