"""A proxy on this machine, for http:// requests and for tunnels (CONNECT), that can delay and break connections."""
import select
import socket
import socketserver
import threading
import time
from urllib.parse import urlsplit


class ProxyServer:
    """Runs while it is entered. `breaks_every`: of so many requests, one ends after half an answer. `hosts`: where the
    hosts are that only this proxy knows, {name: (host, port)}."""

    def __init__(self, delay_s=0.0, breaks_every=0, hosts=None):
        self.delay_s, self.breaks_every, self.hosts = delay_s, breaks_every, hosts or {}
        self.targets, self.broken = [], 0   # URLs of requests and host:port of tunnels
        self.lock = threading.Lock()

    def __enter__(self):
        server = self

        class Handler(ProxyHandler):
            proxy = server

        socketserver.ThreadingTCPServer.allow_reuse_address = True
        self._server = socketserver.ThreadingTCPServer(("127.0.0.1", 0), Handler)
        self._server.daemon_threads = True
        self._thread = threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.02})
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def address(self):
        return f"http://127.0.0.1:{self._server.server_address[1]}"

    def note(self, target):
        """Returns whether this connection breaks."""
        with self.lock:
            self.targets.append(target)
            breaks = bool(self.breaks_every) and len(self.targets) % self.breaks_every == 0
            self.broken += breaks
        time.sleep(self.delay_s)
        return breaks


class ProxyHandler(socketserver.StreamRequestHandler):
    proxy = None

    def handle(self):
        try:
            line = self.rfile.readline().decode()
            headers = []
            while (header := self.rfile.readline().decode()).strip():
                headers.append(header)
            if not line:
                return
            method, target, _ = line.split()
            if method == "CONNECT":
                self.tunnel(target)
            else:
                self.forward(method, target, headers)
        except (BrokenPipeError, ConnectionError):
            pass

    def tunnel(self, target):
        breaks = self.proxy.note(target)
        host, port = target.rsplit(":", 1)
        with socket.create_connection(self.proxy.hosts.get(host, (host, int(port)))) as server:
            self.wfile.write(b"HTTP/1.1 200 Connection established\r\n\r\n")
            while not breaks:
                for ready in select.select([self.connection, server], [], [])[0]:
                    data = ready.recv(1 << 16)
                    if not data:
                        return
                    (server if ready is self.connection else self.connection).sendall(data)

    def forward(self, method, target, headers):
        """One request of a connection, which ends then."""
        breaks = self.proxy.note(target)
        url = urlsplit(target)
        kept = [header for header in headers if not header.lower().startswith(("proxy-", "connection:"))]
        asked = f"{method} {url.path or '/'}{'?' + url.query if url.query else ''} HTTP/1.1\r\n" + "".join(kept)
        with socket.create_connection(self.proxy.hosts.get(url.hostname, (url.hostname, url.port or 80))) as server:
            server.sendall(asked.encode() + b"Connection: close\r\n\r\n")
            answer = b""
            while data := server.recv(1 << 16):
                answer += data
        head, _, body = answer.partition(b"\r\n\r\n")
        self.wfile.write(head + b"\r\n\r\n" + (body[:len(body) // 2] if breaks else body))
