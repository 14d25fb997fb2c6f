"""The live view, against a listener that decodes tev's protocol on its own: what it shows at the end is the image file."""
import array
import pathlib
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
SCENE = str(pathlib.Path(__file__).resolve().parent / "ball.pbrt")
CREATE, UPDATE_STRIDED = 4, 6


class Packet:
    def __init__(self, data):
        self.data, self.at = data, 0

    def number(self, form):
        value, = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return value

    def text(self):
        end = self.data.index(b"\0", self.at)
        value = self.data[self.at:end].decode()
        self.at = end + 1
        return value


class Listener:
    """Accepts one viewer's connection after another and paints what comes."""

    def __init__(self, deaf=False, close_after=None):
        self.server = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self.server.getsockname()[1]}"
        self.images, self.messages, self.updates_at, self.faults = {}, 0, [], []
        self.deaf, self.close_after = deaf, close_after
        self.kept = []
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        while True:
            try:
                connection, _ = self.server.accept()
            except OSError:
                return
            if self.deaf:
                self.kept.append(connection)
                continue
            try:
                with connection:
                    self.read(connection)
            except Exception as fault:  # for the test to see
                self.faults.append(repr(fault))

    def read(self, connection):
        waiting = b""
        while data := connection.recv(1 << 16):
            waiting += data
            while len(waiting) >= 4 and len(waiting) >= struct.unpack_from("<I", waiting)[0]:
                length, = struct.unpack_from("<I", waiting)
                self.take(Packet(waiting[4:length]))
                waiting = waiting[length:]
                if self.close_after is not None and self.messages >= self.close_after:
                    self.server.close()
                    return

    def take(self, packet):
        self.messages += 1
        kind = packet.number("B")
        packet.number("B")  # grab focus
        name = packet.text()
        if kind == CREATE:
            width, height, count = (packet.number("i") for _ in range(3))
            channels = [packet.text() for _ in range(count)]
            self.images[name] = (width, height, {c: [0.0] * (width * height) for c in channels})
        elif kind == UPDATE_STRIDED:
            width, _, planes = self.images[name]
            channels = [packet.text() for _ in range(packet.number("i"))]
            x, y, w, h = (packet.number("i") for _ in range(4))
            offsets = [packet.number("q") for _ in channels]
            strides = [packet.number("q") for _ in channels]
            values = struct.unpack_from(f"<{(len(packet.data) - packet.at) // 4}f", packet.data, packet.at)
            for channel, offset, stride in zip(channels, offsets, strides):
                for i in range(w * h):
                    planes[channel][(y + i // w) * width + x + i % w] = values[offset + i * stride]
            if y == 0:
                self.updates_at.append(time.monotonic())
        else:
            self.faults.append(f"unknown message {kind}")


class LiveView(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def render(self, *options, status=0):
        begin = time.monotonic()
        result = subprocess.run([PROGRAM, "render", SCENE, "-o", "a.exr", "-o", "a.pfm", "--progress", "none", *options],
                                cwd=self.folder, capture_output=True, text=True, timeout=120)
        self.assertEqual(result.returncode, status, result.stderr)
        return result.stderr, time.monotonic() - begin

    def pixels(self):
        """Planes of the .pfm, from the top."""
        _, size, _, data = (self.folder / "a.pfm").read_bytes().split(b"\n", 3)
        width, height = map(int, size.split())
        values = array.array("f", data)
        rows = [values[y * width * 3:(y + 1) * width * 3] for y in reversed(range(height))]
        flat = [value for row in rows for value in row]
        return width, height, {name: flat[c::3] for c, name in enumerate("RGB")}

    def test_it_shows_what_is_written(self):
        listener = Listener()
        errors, _ = self.render("--display-server", listener.address, "--time", "3s", "--resolution", "200x150")
        self.assertEqual(errors, "")
        self.assertEqual(listener.faults, [])
        self.assertEqual(len(listener.images), 1)
        name, (width, height, planes) = next(iter(listener.images.items()))
        self.assertIn("a", name)
        expected = self.pixels()
        self.assertEqual((width, height), expected[:2])
        self.assertEqual(planes, expected[2])
        self.assertGreater(sum(planes["G"]), 0)
        self.assertGreaterEqual(len(listener.updates_at), 3)
        self.assertLessEqual(len(listener.updates_at), 5, "at most one image per second, and the last")

    def test_a_crop_window_has_its_own_size(self):
        listener = Listener()
        self.render("--display-server", listener.address, "--passes", "2", "--crop", "8,24,4,20")
        width, height, planes = next(iter(listener.images.values()))
        self.assertEqual((width, height, planes), self.pixels())
        self.assertEqual((width, height), (16, 16))

    def test_no_viewer_is_a_warning(self):
        with socket.create_server(("127.0.0.1", 0)) as server:
            free = f"127.0.0.1:{server.getsockname()[1]}"
        errors, _ = self.render("--display-server", free, "--passes", "3")
        self.assertEqual(len(errors.splitlines()), 1, errors)
        self.assertIn("goes on without it", errors)

    def test_a_viewer_that_goes_away_is_a_warning(self):
        listener = Listener(close_after=2)
        errors, _ = self.render("--display-server", listener.address, "--time", "3s", "--resolution", "400x300")
        self.assertIn("goes on without it", errors)
        self.assertEqual(len(errors.splitlines()), 1, errors)

    def test_a_viewer_that_does_not_listen_slows_nothing(self):
        listener = Listener(deaf=True)
        _, seconds = self.render("--display-server", listener.address, "--time", "3s", "--resolution", "800x600",
                                 "--layers", "beauty")
        self.assertLess(seconds, 3 + 2 + 4, "the time limit, two seconds for the last image, and the start")

    def test_bad_addresses_are_refused(self):
        for server in ("127.0.0.1:x", "127.0.0.1:0", "127.0.0.1:99999", "no.such.host.invalid:80"):
            errors, _ = self.render("--display-server", server, "--passes", "1", status=2)
            self.assertIn("--display-server", errors)


if __name__ == "__main__":
    unittest.main()
