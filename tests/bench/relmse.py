"""relMSE as `polyrecon compare` computes it: mean of ((x - r)^2 - Var r) / (r^2 + 0.01), r being the reference and
Var r the noise variance of its mean."""

FLOOR = 0.01  # Added to the squared reference, so that dark pixels do not decide


def denominator(reference):
    return reference**2 + FLOOR


def relative_squares(image, reference, variance=0):
    """The terms of the mean."""
    return ((image - reference) ** 2 - variance) / denominator(reference)
