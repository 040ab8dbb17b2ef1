# SPDX-License-Identifier: BSD-3-Clause
"""A recording with something in its images that is not the world: what no landmark may be made of.

python3 disturbed_recordings.py RECORDING OUT KIND [--seed N]

RECORDING: a folder with rgb.txt (and calibration.yaml, a truth): they come along. Needs numpy and OpenCV
(python3-opencv of Debian). KIND is one of

  bonnet10 bonnet20 bonnet30     the lowest part of the image, in per cent: a bonnet that mirrors what is above it
  caption                        a line of text with a clock, and a maker's name
  rim                            black beyond a circle, with a bright ring that flickers
  dust                           forty soft spots on the lens
  arm                            a robot's arm that sways by a hundredth of the image
  follow20 follow40 follow60     a lorry ahead that keeps its distance roughly, over so many per cent of the image; from
                                 a quarter to three quarters of the recording
  overtake20 overtake40 overtake60  one that comes from beside, passes and drives off, every 6 s; so large at most
  cross20 cross40 cross60        one that crosses, every 6 s
  people                         ten figures that walk across
  frozen                         the images of one second are all its first one, in the middle of the recording
  doubled                        each third image is the one before it"""
import argparse
import math
import pathlib
import sys

import cv2
import numpy

from disturbances import KINDS

PERIOD_S = 6  # from one lorry to the next


def split_kind(kind):
    """follow20 -> follow, .2"""
    name = kind.rstrip("0123456789")
    return name, int(kind[len(name):] or 0) / 100


def blend(image, layer, alpha):
    alpha = alpha[..., None] if image.ndim == 3 and alpha.ndim == 2 else alpha
    return (image * (1 - alpha) + layer * alpha).clip(0, 255).astype(numpy.uint8)


def like(image, grey):
    """A grey layer with as many channels as the image."""
    return grey[..., None].repeat(3, axis=2) if image.ndim == 3 else grey


def soft(mask, sigma):
    return cv2.GaussianBlur(mask.astype(numpy.float32), (0, 0), sigma)


def surface(random, height, width):
    """A grey texture of plates, stripes and print, as a lorry has it."""
    texture = numpy.full((height, width), 150, numpy.float32)
    for _ in range(90):
        x, y = int(random.integers(0, width)), int(random.integers(0, height))
        w, h = int(random.integers(4, width // 4)), int(random.integers(4, height // 5))
        cv2.rectangle(texture, (x, y), (x + w, y + h), float(random.uniform(30, 240)), -1)
    for _ in range(12):
        text = "".join(chr(int(c)) for c in random.integers(65, 91, 6))
        at = int(random.integers(0, width)), int(random.integers(20, height))
        cv2.putText(texture, text, at, cv2.FONT_HERSHEY_SIMPLEX, random.uniform(.5, 1.6), float(random.uniform(0, 255)), 2)
    return cv2.GaussianBlur(texture, (0, 0), 1) + random.normal(0, 2, texture.shape).astype(numpy.float32)


class Bonnet:
    def __init__(self, share, random, height, width, _focal):
        y, x = numpy.mgrid[0:height, 0:width].astype(numpy.float32)
        # An arch that is higher in the middle, with a bead along it.
        top = height * (1 - share) + .35 * share * height * ((x / width - .5) * 2) ** 2
        self.alpha = soft(y > top, 1)
        self.top = int(height * (1 - share))
        self.fixed = 40 + 60 * numpy.exp(-((y - top - 6) / 3) ** 2)
        for _ in range(12):  # seams, a nozzle, dirt
            a = int(random.integers(0, width)), int(random.integers(self.top, height))
            b = int(a[0] + random.normal(0, width * .1)), int(a[1] + random.normal(0, height * .03))
            cv2.line(self.fixed, a, b, float(random.uniform(20, 110)), 2)
        self.reach = height - self.top

    def draw(self, image, _now_s, _share_done):
        # A mirror, bent and blurred, of what is above it: it moves the other way.
        source = image[max(0, self.top - 3 * self.reach):self.top]
        mirrored = cv2.flip(cv2.resize(source, (image.shape[1], self.reach)), 0)
        layer = like(image, self.fixed).copy()
        layer[self.top:] += .45 * cv2.GaussianBlur(mirrored, (0, 0), 1.5)
        return blend(image, layer, self.alpha)


class Caption:
    def __init__(self, _share, _random, height, width, _focal):
        self.scale = width / 640 * .55

    def draw(self, image, now_s, _share_done):
        height = image.shape[0]
        out = image.copy()
        for text, x in (("MAKER", .01), (f"2026-11-29 12:{int(now_s) // 60:02d}:{int(now_s) % 60:02d}  48.1372 11.5755", .2)):
            at = int(x * image.shape[1]), height - int(10 * self.scale)
            cv2.putText(out, text, at, cv2.FONT_HERSHEY_SIMPLEX, self.scale, (0, 0, 0), 4, cv2.LINE_AA)
            cv2.putText(out, text, at, cv2.FONT_HERSHEY_SIMPLEX, self.scale, (255, 255, 255), 1, cv2.LINE_AA)
        return out


class Rim:
    def __init__(self, _share, random, height, width, _focal):
        y, x = numpy.mgrid[0:height, 0:width].astype(numpy.float32)
        self.radius = numpy.hypot(x - .5 * width, y - .5 * height)
        self.limit = .47 * max(height, width)
        angle = numpy.arctan2(y - .5 * height, x - .5 * width)
        ragged = self.limit + 3 * numpy.sin(9 * angle) + 2 * numpy.sin(23 * angle)
        self.alpha = soft(self.radius > ragged, 1)
        self.ring = numpy.exp(-((self.radius - ragged) / 4) ** 2)
        self.random = random

    def draw(self, image, _now_s, _share_done):
        bright = 10 + self.random.uniform(40, 110) * self.ring
        return blend(image, like(image, bright), self.alpha)


class Dust:
    def __init__(self, _share, random, height, width, _focal):
        self.alpha = numpy.zeros((height, width), numpy.float32)
        self.layer = numpy.zeros((height, width), numpy.float32)
        for _ in range(40):
            spot = numpy.zeros((height, width), numpy.float32)
            at = int(random.integers(0, width)), int(random.integers(0, height))
            cv2.circle(spot, at, int(random.integers(2, max(3, width // 90))), 1.0, -1)
            spot = .8 * soft(spot, width / 500)
            self.layer = numpy.where(spot > self.alpha, random.choice([30, 220]), self.layer)
            self.alpha = numpy.maximum(self.alpha, spot)

    def draw(self, image, _now_s, _share_done):
        return blend(image, like(image, self.layer), self.alpha)


class Arm:
    def __init__(self, _share, random, height, width, _focal):
        self.layer = surface(random, height, width)
        self.alpha = numpy.zeros((height, width), numpy.float32)
        points = numpy.array([[.55, 1.1], [.5, .75], [.3, .6], [.33, .52], [.6, .68], [.75, 1.1]]) * [width, height]
        cv2.fillPoly(self.alpha, [points.astype(numpy.int32)], 1.0)
        self.size = .01 * width

    def draw(self, image, now_s, _share_done):
        shift = numpy.float32([[1, 0, self.size * math.sin(1.3 * now_s)], [0, 1, self.size * math.sin(1.9 * now_s)]])
        size = image.shape[1], image.shape[0]
        layer, alpha = (cv2.warpAffine(a, shift, size, borderMode=cv2.BORDER_REPLICATE) for a in (self.layer, self.alpha))
        return blend(image, like(image, layer), cv2.GaussianBlur(alpha, (0, 0), 1))


class Lorry:
    """A box with two faces that are seen, moving by itself before the camera."""

    LENGTH = 2.5  # of its back's height

    def __init__(self, kind, share, random, height, width, focal):
        self.kind, self.focal = kind, focal
        self.back, self.side = surface(random, 300, 300), surface(random, 300, 600)
        # Its back, of height 1, has the share of the image and fits into it.
        back_px = min(math.sqrt(share * height * width), .95 * height)
        self.near = focal / back_px
        self.half = .5 * share * height * width / back_px / back_px  # of its width
        self.width, self.height = width, height

    def place(self, now_s, share_done):
        """Centre of its back, in units of the back's height; None while it is not there."""
        half_view = .5 * self.width / self.focal * self.near
        if self.kind == "follow":
            if not .25 <= share_done <= .75:
                return None
            return (.1 * self.near * math.sin(.5 * now_s), .03 * self.near * math.sin(5 * now_s),
                    self.near * (1.1 + .1 * math.sin(.7 * now_s)))
        phase = now_s % PERIOD_S / PERIOD_S
        if self.kind == "cross":
            return (half_view + self.half) * (3 * phase - 1.5), .05, self.near
        depth = self.near * (1 + 6 * max(0, phase - .25) ** 2)  # overtaking: it comes beside and drives off
        return -(half_view + self.half) * (1 - phase) * (1 + 1.5 * phase), .1, depth

    def draw(self, image, now_s, share_done):
        place = self.place(now_s, share_done)
        if place is None:
            return image
        x, y, z = place
        left, right, top, low, far = x - self.half, x + self.half, y - .5, y + .5, z + self.LENGTH
        out = image
        faces = []
        inner = right if x < 0 else left
        if abs(x) > self.half:  # the face towards the camera's axis is seen, too
            faces.append((self.side, [(inner, top, z), (inner, top, far), (inner, low, far), (inner, low, z)]))
        faces.append((self.back, [(left, top, z), (right, top, z), (right, low, z), (left, low, z)]))
        for texture, corners in faces:
            pixels = numpy.float32([(.5 * self.width + self.focal * a / c, .5 * self.height + self.focal * b / c) for a, b, c in corners])
            h, w = texture.shape
            homography = cv2.getPerspectiveTransform(numpy.float32([(0, 0), (w, 0), (w, h), (0, h)]), pixels)
            size = image.shape[1], image.shape[0]
            alpha = cv2.warpPerspective(numpy.ones_like(texture), homography, size)
            layer = cv2.warpPerspective(texture, homography, size, borderMode=cv2.BORDER_REPLICATE)
            out = blend(out, like(image, layer), alpha)
        return out


class People:
    def __init__(self, _share, random, height, width, _focal):
        self.height, self.width = height, width
        self.people = [(random.uniform(.25, .6), random.uniform(.55, .8), random.uniform(-.25, .25), random.uniform(0, 1),
                        surface(random, 200, 200)) for _ in range(10)]

    def draw(self, image, now_s, _share_done):
        out = image
        for tall, foot, speed, begin, cloth in sorted(self.people, key=lambda p: p[0]):
            size = tall * self.height
            x = ((begin + speed * now_s) % 1.3 - .15) * self.width
            y = foot * self.height + .02 * size * abs(math.sin(8 * now_s + 6 * begin))
            shape = numpy.zeros((self.height, self.width), numpy.float32)
            swing = .15 * size * math.sin(4 * now_s + 6 * begin)
            at = lambda dx, dy: (int(x + dx), int(y + dy))
            cv2.ellipse(shape, at(0, -.2 * size), (int(.13 * size), int(.22 * size)), 0, 0, 360, 1.0, -1)
            cv2.circle(shape, at(0, -.48 * size), max(2, int(.08 * size)), 1.0, -1)
            for side in (-1, 1):
                cv2.line(shape, at(0, 0), at(side * swing, .4 * size), 1.0, max(2, int(.09 * size)))
                cv2.line(shape, at(0, -.35 * size), at(-side * swing, -.05 * size), 1.0, max(2, int(.06 * size)))
            place = numpy.float32([[size / 200, 0, x - .5 * size], [0, size / 200, y - .5 * size]])
            layer = cv2.warpAffine(cloth, place, (self.width, self.height), borderMode=cv2.BORDER_REFLECT)
            out = blend(out, like(image, layer), cv2.GaussianBlur(shape, (0, 0), 1))
        return out


MAKERS = {"bonnet": Bonnet, "caption": Caption, "rim": Rim, "dust": Dust, "arm": Arm, "people": People}


def make_painter(kind, random, shape, focal):
    name, share = split_kind(kind)
    height, width = shape[:2]
    if name in ("follow", "overtake", "cross"):
        return Lorry(name, share, random, height, width, focal)
    return MAKERS[name](share, random, height, width, focal)


def read_rows(path):
    return [line.split(maxsplit=1) for line in path.read_text().splitlines() if line.strip() and not line.startswith("#")]


def read_focal(path, width):
    for line in path.read_text().splitlines() if path.exists() else []:
        if line.startswith("fx:"):
            return float(line.split()[1])
    return .8 * width


def repeat(kind, rows):
    """Which file each time shows."""
    times, files = [float(t) for t, _ in rows], [f.strip() for _, f in rows]
    if kind == "doubled":
        return [files[i - 1] if i % 3 == 2 else f for i, f in enumerate(files)]
    begin = times[len(times) // 2]
    first = files[len(times) // 2]
    return [first if begin <= t < begin + 1 else f for t, f in zip(times, files)]


def disturb(source, out, kind, seed):
    rows = read_rows(source / "rgb.txt")
    if not rows:
        sys.exit(f"{source / 'rgb.txt'}: no images")
    out.mkdir(parents=True, exist_ok=True)
    for path in source.iterdir():
        if path.is_file() and path.name != "rgb.txt" and not (out / path.name).exists():
            (out / path.name).symlink_to(path.resolve())
    if kind in ("frozen", "doubled"):
        link = out / "images"
        if not link.exists():
            link.symlink_to(source.resolve())
        shown = repeat(kind, rows)
        (out / "rgb.txt").write_text("".join(f"{t} images/{f}\n" for (t, _), f in zip(rows, shown)))
        return
    (out / "rgb").mkdir(exist_ok=True)
    random = numpy.random.default_rng(seed)
    painter, lines = None, []
    begin, end = float(rows[0][0]), float(rows[-1][0])
    for i, (t, name) in enumerate(rows):
        image = cv2.imread(str(source / name.strip()), cv2.IMREAD_UNCHANGED)
        if image is None:
            sys.exit(f"{source / name.strip()}: not an image")
        if painter is None:
            painter = make_painter(kind, random, image.shape, read_focal(source / "calibration.yaml", image.shape[1]))
        now_s = float(t) - begin
        drawn = painter.draw(image, now_s, now_s / max(1e-9, end - begin))
        cv2.imwrite(str(out / "rgb" / f"{i:06d}.jpg"), drawn, [cv2.IMWRITE_JPEG_QUALITY, 90])
        lines.append(f"{t} rgb/{i:06d}.jpg\n")
    (out / "rgb.txt").write_text("".join(lines))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recording", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("--seed", type=int, default=0)
    a = parser.parse_args()
    if not (a.recording / "rgb.txt").exists():
        sys.exit(f"{a.recording}: no folder with rgb.txt")
    disturb(a.recording, a.out, a.kind, a.seed)


if __name__ == "__main__":
    main()
