"""The commands: read files, call the library, write files.

`flexsurr <name>`, or `python -m flexsurr <name>`, runs one; `--help` lists its options. Those of the workflow
take `--job <file>`, which holds exactly the values that the command depends on (flexsurr/workflow/plan.py).
"""
