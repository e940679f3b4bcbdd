# %% [markdown]
# # polyrecon in a notebook
# Editors and Jupyter (by jupytext) open this file as cells. Pictures need matplotlib.

# %%
import pathlib
import sys

import numpy as np
import polyrecon

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "samples")

# %% [markdown]
# ## Read
# `read` finds the passes by their names and says in the report what it found.

# %%
render = polyrecon.read(folder / "study_16.exr")
for role in render.report["roles"]:
    print(f"{role['role']:10} {role['holds']:22} {role['layer']}")
print({name: array.shape for name, array in render.items()})

# %% [markdown]
# ## Denoise
# The progress function may stop the work, and so does "interrupt kernel".


# %%
def progress(phase, done):
    print(f"\r{phase:24} {done:4.0%}", end="")
    return True


clean = polyrecon.denoise(render, quality="draft", budget=16, progress=progress)
print()

# %% [markdown]
# ## Look at it
# `clean.relmse` is the estimated error of each pixel, `clean.samples` where 16 more samples per pixel help most.

# %%
reference = polyrecon.read(folder / "study_ref.exr")["beauty"]


def relative_error(image):
    return np.mean((image - reference) ** 2 / (reference**2 + 0.01))


print(f"relMSE {relative_error(render['beauty']):.5f} -> {relative_error(clean.image):.5f}")
print(f"estimated {clean.relmse.mean():.5f}; samples of a pixel {clean.samples.min():.0f} to {clean.samples.max():.0f}")

# %%
try:
    import matplotlib.pyplot as plt
except ImportError:
    print("pip install matplotlib to see the pictures")
else:
    _, axes = plt.subplots(1, 3, figsize=(18, 6))
    axes[0].imshow(np.clip(render["beauty"], 0, 1) ** (1 / 2.2))
    axes[1].imshow(np.clip(clean.image, 0, 1) ** (1 / 2.2))
    axes[2].imshow(np.log10(clean.relmse + 1e-6), cmap="inferno")
    plt.show()

# %% [markdown]
# ## Write
# A copy of the render with the picture replaced; all other layers stay.

# %%
polyrecon.write("clean.exr", clean, like=folder / "study_16.exr")
