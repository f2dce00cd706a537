"""A study on a Ray cluster: on_ray.py STUDY TASKS DIR"""
import os, subprocess, sys
import ray

def xcscr(*words):
    subprocess.run(["xcscr", "study", *map(str, words)], check=True)

@ray.remote(num_cpus=1, max_retries=3, retry_exceptions=True)
def task(folder, number):
    xcscr("task", folder, number, "--jobs", 1, "--quiet")

study, tasks, folder = sys.argv[1], int(sys.argv[2]), os.path.abspath(sys.argv[3])
xcscr("plan", study, "--tasks", tasks, "--out", folder)
ray.init()
ray.get([task.remote(folder, number + 1) for number in range(tasks)])
xcscr("report", folder)
