"""Lorenz's equations with their mirror, and the same with places beside them that nothing depends on.

Those are a place s that the mirror reverses, and a height h that it does not and that grows for ever.
"""

SIGMA, B = 10.0, 8.0 / 3.0


def field(t, x, p, dx):
    dx[0] = SIGMA * (x[1] - x[0])
    dx[1] = x[0] * (p.rho - x[2]) - x[1]
    dx[2] = x[0] * x[1] - B * x[2]


def travelling(t, x, p, dx):
    field(t, x, p, dx)
    dx[3] = x[0]
    dx[4] = x[2]


def mirror(t, x, p, image):
    image[0], image[1], image[2] = -x[0], -x[1], x[2]


def travelling_mirror(t, x, p, image):
    mirror(t, x, p, image)
    image[3], image[4] = -x[3], x[4]
