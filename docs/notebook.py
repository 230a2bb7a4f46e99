"""A tour of the package, cell by cell: run it whole, or open it in an editor that knows `# %%`."""

# %% A map is an array. The whole torus, one number for each start: seconds until the second bob flips.
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import flipmap

home = flipmap.render(size=(360, 360), budget=15)
flipped = home["status"] == flipmap.Status.FLIPPED
forbidden = home["status"] == flipmap.Status.FORBIDDEN
print(f"{flipped.mean():.1%} flip within 15 s; energy forbids {forbidden.mean():.1%}")
print(f"{home.seconds:.2f} s on {home.engine}")

# %% How much of a chaotic window is left to guess? `exact` checks every pixel and marks the rest.
exact = flipmap.render("filigree", size=(120, 90), accuracy="exact")
quick = flipmap.render("filigree", size=(120, 90), accuracy="lesson")
sure = ~exact.uncertain
same = (exact["status"] == quick["status"]) & ~(np.abs(exact["time"] - quick["time"]) > 1e-3)
print(f"{sure.mean():.2%} of exact is sure; of that, the lesson's RK4 has {same[sure].mean():.1%} right")

# %% Every pendulum at one moment: an array of states, and a histogram of their energies' shape.
state = flipmap.render(ask="state", at=8, budget=8, size=(240, 240))
print(f"after 8 s the outer bobs turned {np.abs(state['turns2']).mean():.2f} times on average")

# %% One pendulum of that map, in double-double, with every pass of the top.
one = flipmap.trace((2.2, 1.4), until=10, every=0.02)
print(f"{len(one)} rows, {len(one.passes)} passes, energy kept to {np.abs(one['energy_error']).max():.0e}")

# %% Pictures of it all.
figure, axes = plt.subplots(2, 2, figsize=(9, 9), layout="constrained")
around = [0, 2 * np.pi, -np.pi, np.pi]
times = np.where(flipped, home["time"], np.nan)
axes[0, 0].imshow(np.log(times), extent=around, cmap="magma_r")
axes[0, 0].set(title="log of the seconds until a flip", xlabel="θ1, rad", ylabel="θ2, rad")
axes[0, 1].imshow(np.where(exact.uncertain, np.nan, np.log(exact["time"])), cmap="magma_r")
axes[0, 1].set(title="filigree, every pixel checked", xticks=[], yticks=[])
axes[1, 0].imshow(state["theta2"], extent=around, cmap="twilight")
axes[1, 0].set(title="θ2 after 8 s", xlabel="θ1, rad", ylabel="θ2, rad")
axes[1, 1].plot(one["t"], one["theta1"], one["t"], one["theta2"])
axes[1, 1].set(title="one pendulum", xlabel="s", ylabel="rad")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "notebook.png", dpi=80)
