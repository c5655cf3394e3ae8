"""What `study.py` is made of.

`grid` reads what is to be made, `task` makes and measures one table, `engines` run tasks here or on other
machines, `results` keeps rows, `plot` draws them.
"""
