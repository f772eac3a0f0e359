"""What tests share with each other and with benchmarks: texts, tasks and frames to try things on, slow
references to compare with, robots and planners that follow a script."""
