"""A server of a large OME-Zarr that is computed, and that answers in rounds: it holds all requests until the program that
asks waits for nothing else, so that round trips that follow each other are counted and not timed."""
import json
import threading
import time
from pathlib import Path

from store_server import StoreServer

CHUNK = 64


class PyramidServer(StoreServer):
    """x.zarr: side^3 voxels of uint8 and coarser levels down to one chunk, a ball in the middle, no chunks outside it."""

    def __init__(self, side, holds=True):
        super().__init__(".", self.hold if holds else None)
        self.levels = [side >> level for level in range(side.bit_length()) if side >> level >= CHUNK]
        self.held, self.round = 0, 0
        self.released = threading.Condition()

    # ---- What is served

    def read(self, key):
        name, _, inner = key.partition("/")
        if name != "x.zarr":
            return None
        if inner == ".zattrs":
            axes = [{"name": axis, "type": "space", "unit": "micrometer"} for axis in "zyx"]
            datasets = [{"path": str(level), "coordinateTransformations": [
                {"type": "scale", "scale": [float(1 << level)] * 3},
                {"type": "translation", "translation": [0.5 * ((1 << level) - 1)] * 3}]} for level in range(len(self.levels))]
            return json.dumps({"multiscales": [{"version": "0.4", "axes": axes, "datasets": datasets}]}).encode()
        if inner == ".zgroup":
            return b'{"zarr_format": 2}'
        level, _, rest = inner.partition("/")
        if not level.isdigit() or int(level) >= len(self.levels):
            return None
        side = self.levels[int(level)]
        if rest == ".zarray":
            return json.dumps({"zarr_format": 2, "shape": [side] * 3, "chunks": [CHUNK] * 3, "dtype": "|u1", "order": "C",
                               "compressor": None, "filters": None, "fill_value": 0, "dimension_separator": "/"}).encode()
        return self.chunk(side, [int(number) for number in rest.split("/")])

    @staticmethod
    def chunk(side, place):
        """In the ball, a chunk has its own value; a chunk that is the whole level is half full."""
        if side == CHUNK:
            return bytes(CHUNK ** 3 // 4) + bytes([180]) * (CHUNK ** 3 // 2) + bytes(CHUNK ** 3 // 4)
        distance = sum(((number + 0.5) * CHUNK / side - 0.5) ** 2 for number in place) ** 0.5
        return bytes([150 + (7 * place[0] + 3 * place[1] + place[2]) % 100]) * CHUNK ** 3 if distance < 0.4 else None

    # ---- Rounds

    def hold(self, *_):
        with self.released:
            number = self.round
            self.held += 1
            self.released.wait_for(lambda: self.round > number)

    def release(self):
        """Answers all requests that are held."""
        with self.released:
            self.held = 0
            self.round += 1
            self.released.notify_all()

    def rests(self, process, turns, rest_s=0.25):
        """Whether nothing happens for a while: no request arrives, no thread that loads runs or wants to, and the main
        thread has had some turns, which `turns` counts. So a slow machine is no reason for more rounds."""
        before, first, end = len(self.requests), turns(), time.monotonic() + rest_s
        while time.monotonic() < end or turns() < first + 3:
            if len(self.requests) != before or any(state not in "SI" for state in states_of_loaders(process)):
                return False
            time.sleep(0.01)
        return True


def states_of_loaders(process):
    """The states of a program's threads, one letter each, without the main thread and those that draw."""
    states = []
    for task in Path(f"/proc/{process.pid}/task").iterdir():
        try:
            name, state = (task / "comm").read_text(), (task / "stat").read_text().rpartition(")")[2].split()[0]
        except OSError:   # it has ended
            continue
        if task.name != str(process.pid) and "pipe" not in name and not name.startswith(("WSI", "shvr:disk", "[vk")):
            states.append(state)
    return states
