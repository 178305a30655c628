import os
import subprocess
import sys
import time

import psutil

from railjoule.dashboard.work.study_pool import NICE, StudyPool

SERVER = """
import os, time
from railjoule.dashboard.work.study_pool import StudyPool

if __name__ == "__main__":
    pool = StudyPool(lambda: 1, 5)
    print(pool.executor().submit(os.getpid).result(), flush=True)
    time.sleep(60)
"""
ENDS_WITHIN_S = 20


def test_pieces_are_done_in_other_processes_of_a_lower_priority() -> None:
    pool = StudyPool(lambda: 1, NICE)
    first = pool.executor().submit(os.getpid).result()
    assert first != os.getpid()
    # 19 is the lowest priority there is
    assert psutil.Process(first).nice() == min(psutil.Process().nice() + NICE, 19)
    assert pool.executor().submit(os.getpid).result() == first
    pool.renew()
    assert pool.executor().submit(os.getpid).result() != first
    pool.renew()


def test_workers_end_with_a_server_that_is_killed(tmp_path: object) -> None:
    path = f"{tmp_path}/server.py"
    with open(path, "w", encoding="utf-8") as file:
        file.write(SERVER)
    server = subprocess.Popen([sys.executable, path], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    worker = int(server.stdout.readline())
    assert psutil.pid_exists(worker)
    server.kill()
    server.wait()
    server.stdout.close()
    deadline = time.monotonic() + ENDS_WITHIN_S
    while psutil.pid_exists(worker) and psutil.Process(worker).status() != "zombie" and time.monotonic() < deadline:
        time.sleep(0.1)
    assert not psutil.pid_exists(worker) or psutil.Process(worker).status() == "zombie"
