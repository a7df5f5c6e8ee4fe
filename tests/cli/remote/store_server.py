"""A small HTTP server on this machine that serves a folder like an object store: ranges, ETags, no listing; and faults."""
import hashlib
import http.server
import re
import socket
import struct
import threading
import time
from pathlib import Path
from urllib.parse import unquote


class StoreServer:
    """Serves `folder` while it is entered. `fault`: called with the path of a request and how often it was asked for
    before; returns None, or a function that answers with the request's handler instead."""

    def __init__(self, folder, fault=None):
        self.folder, self.fault = Path(folder), fault
        self.requests = []  # (path with query, headers)
        self.check = None  # called with (path with query, headers); False: status 403
        self.busy, self._lock = 0, threading.Lock()  # requests that are being answered

    def __enter__(self):
        server = self

        class Handler(StoreHandler):
            store = server

        self._http = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self._http.daemon_threads = True
        self._thread = threading.Thread(target=self._http.serve_forever, kwargs={"poll_interval": 0.02})
        self._thread.start()
        self.port = self._http.server_address[1]
        return self

    def __exit__(self, *_):
        self._http.shutdown()
        self._http.server_close()
        self._thread.join()

    def address(self, name=""):
        return f"http://127.0.0.1:{self.port}/{name}"

    def paths(self):
        return [path for path, _ in self.requests]

    def read(self, key):
        """The bytes of an object; None if there is no such object."""
        path = self.folder / key
        return path.read_bytes() if path.is_file() else None


class StoreHandler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    store = None

    def log_message(self, *_):
        pass

    def do_GET(self):
        store = self.store
        with store._lock:
            count = store.paths().count(self.path)
            store.requests.append((self.path, dict(self.headers)))
            store.busy += 1
        try:
            fault = store.fault and store.fault(self.path, count)
            if fault:
                fault(self)
            elif store.check and not store.check(self.path, self.headers):
                self.answer(403)
            else:
                self.send_object()
        except (BrokenPipeError, ConnectionResetError):
            self.close_connection = True
        finally:
            with store._lock:
                store.busy -= 1

    def answer(self, status, body=b"", headers=()):
        self.send_response(status)
        for name, value in headers:
            self.send_header(name, value)
        if status != 304:
            self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def content(self):
        return self.store.read(unquote(self.path.split("?")[0]).lstrip("/"))

    def send_object(self):
        body = self.content()
        if body is None:
            return self.answer(404, b"no such key")
        etag = f'"{hashlib.md5(body).hexdigest()}"'
        headers = [("ETag", etag), ("Accept-Ranges", "bytes")]
        if self.headers.get("If-None-Match") == etag:
            return self.answer(304, headers=headers)
        part = re.fullmatch(r"bytes=(\d*)-(\d*)", self.headers.get("Range", ""))
        if not part:
            return self.answer(200, body, headers)
        first = int(part[1]) if part[1] else max(0, len(body) - int(part[2]))
        last = min(int(part[2]), len(body) - 1) if part[1] and part[2] else len(body) - 1
        if first > last:
            return self.answer(416, headers=[("Content-Range", f"bytes */{len(body)}")])
        self.answer(206, body[first:last + 1], [*headers, ("Content-Range", f"bytes {first}-{last}/{len(body)}")])


# ---- Faults -----------------------------------------------------------------------------------------------------------


def status(code, **headers):
    return lambda handler: handler.answer(code, b"fault", [(name.replace("_", "-"), v) for name, v in headers.items()])


def reset(handler):
    """Ends the connection without an answer."""
    handler.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    handler.connection.close()
    handler.close_connection = True


def endless(handler):
    """A body without an end (a gigabyte, should nobody stop it)."""
    handler.send_response(200)
    handler.end_headers()
    handler.close_connection = True
    for _ in range(1 << 14):
        handler.wfile.write(b" " * (1 << 16))


def endless_headers(handler):
    handler.connection.sendall(b"HTTP/1.1 200 OK\r\n")
    handler.close_connection = True
    for number in range(1 << 16):
        handler.connection.sendall(b"X-%d: %s\r\n" % (number, b"x" * 1000))


def too_short(handler):
    """Fewer bytes than the header states."""
    body = handler.content() or b""
    handler.send_response(200)
    handler.send_header("Content-Length", str(len(body) + 10))
    handler.end_headers()
    handler.wfile.write(body)
    handler.close_connection = True


def drip(handler):
    """One byte at a time, so slowly that it would take minutes."""
    handler.send_response(200)
    handler.send_header("Content-Length", "1000")
    handler.end_headers()
    handler.close_connection = True
    for _ in range(1000):
        handler.wfile.write(b" ")
        time.sleep(0.3)


def silent(handler):
    handler.close_connection = True
    handler.connection.settimeout(60)
    handler.connection.recv(1)
