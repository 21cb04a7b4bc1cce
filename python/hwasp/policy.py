"""Trained controllers."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import Literal

    import numpy as np
    import torch
    from numpy.typing import ArrayLike, NDArray

    from . import _hwasp

__all__ = ["Policy"]


class Policy:
    """The deterministic controller of a run, on the design as built.

    `policy(observation)` gives the commands, SI: `(O,)` to `(C,)`, or a batch `(rows, O)` to `(rows, C)`, within the motors'
    limits. `observations` and `commands` name what goes in and comes out.
    """

    def __init__(self, native: _hwasp.Policy) -> None:
        self._native = native

    def __call__(self, observation: ArrayLike) -> NDArray[np.float64]:
        return self._native(observation)

    @property
    def observations(self) -> list[tuple[str, str]]:
        """Names and units of what it sees, in order."""
        return self._native.observations

    @property
    def commands(self) -> list[tuple[str, str, float, float]]:
        """Name, unit, lower and upper limit of each command, in order."""
        return self._native.commands

    @property
    def time_step(self) -> float:
        """Time between two commands, s."""
        return self._native.time_step

    def state_dict(self) -> dict[str, NDArray[np.float32]]:
        """Every tensor of the policy as a numpy array, by its name in `policy.safetensors`: weights `(inputs, outputs)`, what it subtracts from
        observations and divides them by, design, log standard deviations."""
        return self._native.state_dict()

    def layers(self) -> list[tuple[NDArray[np.float32], NDArray[np.float32], Literal["tanh", "relu", "identity"]]]:
        """The controller's layers: weight `(outputs, inputs)`, bias `(outputs,)`, and what follows (`"tanh"`, `"relu"`, `"identity"`)."""
        return self._native.layers()

    def to_torch(self) -> torch.nn.Module:
        """The same function as a `torch.nn.Module`, observations in SI to commands in SI, single precision."""
        import torch

        activations = {"tanh": torch.nn.Tanh, "relu": torch.nn.ReLU, "identity": torch.nn.Identity}
        center, scale, clip = self._native.normalizer()
        low = torch.tensor([port[2] for port in self.commands], dtype=torch.float32)
        high = torch.tensor([port[3] for port in self.commands], dtype=torch.float32)
        parts: list[torch.nn.Module] = []
        for weight, bias, activation in self.layers():
            linear = torch.nn.Linear(*reversed(weight.shape))
            with torch.no_grad():
                linear.weight.copy_(torch.from_numpy(weight.copy()))
                linear.bias.copy_(torch.from_numpy(bias.copy()))
            parts += [linear, activations[activation]()]
        network = torch.nn.Sequential(*parts)

        class Controller(torch.nn.Module):  # type: ignore[misc]
            center: torch.Tensor
            scale: torch.Tensor
            low: torch.Tensor
            high: torch.Tensor

            def __init__(self) -> None:
                super().__init__()
                self.network = network
                self.register_buffer("center", torch.from_numpy(center).float())
                self.register_buffer("scale", torch.from_numpy(scale).float())
                self.register_buffer("low", low)
                self.register_buffer("high", high)

            def forward(self, observation: torch.Tensor) -> torch.Tensor:
                seen = (observation - self.center) / self.scale
                if clip is not None:
                    seen = seen.clamp(-clip, clip)
                command: torch.Tensor = self.network(seen) * (0.5 * (self.high - self.low)) + 0.5 * (self.high + self.low)
                return command.clamp(self.low, self.high)

        return Controller()

    def __repr__(self) -> str:
        return repr(self._native)
