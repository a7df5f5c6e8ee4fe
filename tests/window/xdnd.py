"""Files dropped onto a window as a file manager does it: by the protocol XDND, version 5, over libX11."""
import ctypes
import time
import urllib.parse

CLIENT_MESSAGE, SELECTION_REQUEST, SELECTION_NOTIFY = 33, 30, 31
REPLACE, CURRENT_TIME, NO_MASK = 0, 0, 0
VERSION = 5


class ClientMessage(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("window", ctypes.c_ulong), ("message_type", ctypes.c_ulong),
                ("format", ctypes.c_int), ("data", ctypes.c_long * 5)]


class SelectionRequest(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("owner", ctypes.c_ulong), ("requestor", ctypes.c_ulong),
                ("selection", ctypes.c_ulong), ("target", ctypes.c_ulong), ("property", ctypes.c_ulong),
                ("time", ctypes.c_ulong)]


class SelectionNotify(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("requestor", ctypes.c_ulong), ("selection", ctypes.c_ulong),
                ("target", ctypes.c_ulong), ("property", ctypes.c_ulong), ("time", ctypes.c_ulong)]


class Event(ctypes.Union):
    _fields_ = [("type", ctypes.c_int), ("client", ClientMessage), ("request", SelectionRequest),
                ("notify", SelectionNotify), ("size", ctypes.c_long * 24)]


def x11():
    library = ctypes.CDLL("libX11.so.6")
    for name, result in (("XOpenDisplay", ctypes.c_void_p), ("XDefaultRootWindow", ctypes.c_ulong),
                         ("XCreateSimpleWindow", ctypes.c_ulong), ("XInternAtom", ctypes.c_ulong)):
        getattr(library, name).restype = result
    return library


class Source:
    """A program that holds files over the window of another."""

    def __init__(self, display_name, target):
        self.x, self.target = x11(), target
        self.display = ctypes.c_void_p(self.x.XOpenDisplay(display_name.encode()))
        if not self.display:
            raise RuntimeError(f"display {display_name} cannot be opened")
        root = self.x.XDefaultRootWindow(self.display)
        self.window = self.x.XCreateSimpleWindow(self.display, ctypes.c_ulong(root), 0, 0, 1, 1, 0, ctypes.c_ulong(0),
                                                 ctypes.c_ulong(0))
        self.uris = self.atom("text/uri-list")

    def atom(self, name):
        return self.x.XInternAtom(self.display, name.encode(), 0)

    def tell(self, message, *data):
        event = Event()
        event.client.type, event.client.window, event.client.format = CLIENT_MESSAGE, self.target, 32
        event.client.message_type = self.atom(message)
        for i, value in enumerate([self.window, *data]):
            event.client.data[i] = value
        self.x.XSendEvent(self.display, ctypes.c_ulong(self.target), 0, ctypes.c_long(NO_MASK), ctypes.byref(event))
        self.x.XFlush(self.display)

    def next_event(self, patience_s):
        end = time.monotonic() + patience_s
        while not self.x.XPending(self.display):
            if time.monotonic() > end:
                raise TimeoutError("the window does not answer to files that are held over it")
            time.sleep(0.01)
        event = Event()
        self.x.XNextEvent(self.display, ctypes.byref(event))
        return event

    def answer(self, request, paths):
        text = "".join(f"file://{urllib.parse.quote(str(path))}\r\n" for path in paths).encode()
        self.x.XChangeProperty(self.display, ctypes.c_ulong(request.requestor), ctypes.c_ulong(request.property),
                               ctypes.c_ulong(request.target), 8, REPLACE, text, len(text))
        event = Event()
        event.notify.type, event.notify.requestor, event.notify.time = SELECTION_NOTIFY, request.requestor, request.time
        event.notify.selection, event.notify.target = request.selection, request.target
        event.notify.property = request.property
        self.x.XSendEvent(self.display, ctypes.c_ulong(request.requestor), 0, ctypes.c_long(NO_MASK),
                          ctypes.byref(event))
        self.x.XFlush(self.display)

    def drop(self, paths, at, patience_s=60):
        """Returns once the window says that it has them."""
        self.x.XSetSelectionOwner(self.display, ctypes.c_ulong(self.atom("XdndSelection")),
                                  ctypes.c_ulong(self.window), ctypes.c_ulong(CURRENT_TIME))
        self.tell("XdndEnter", VERSION << 24, self.uris, 0, 0)
        self.tell("XdndPosition", 0, at[0] << 16 | at[1], CURRENT_TIME, self.atom("XdndActionCopy"))
        status, finished = self.atom("XdndStatus"), self.atom("XdndFinished")
        while True:
            event = self.next_event(patience_s)
            if event.type == CLIENT_MESSAGE and event.client.message_type == status:
                if not event.client.data[1] & 1:
                    raise RuntimeError("the window does not take files")
                self.tell("XdndDrop", 0, CURRENT_TIME)
            elif event.type == SELECTION_REQUEST:
                self.answer(event.request, paths)
            elif event.type == CLIENT_MESSAGE and event.client.message_type == finished:
                return

    def close(self):
        self.x.XCloseDisplay(self.display)
