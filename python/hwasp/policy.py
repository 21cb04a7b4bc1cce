"""Trained controllers."""

__all__ = ["Policy"]


class Policy:
    """The deterministic controller of a run, on the design as built.

    `policy(observation)` gives the commands, SI: `(O,)` to `(C,)`, or a batch `(rows, O)` to `(rows, C)`, within the motors'
    limits. `observations` and `commands` name what goes in and comes out.
    """

    def __init__(self, native):
        self._native = native

    def __call__(self, observation):
        return self._native(observation)

    @property
    def observations(self):
        """Names and units of what it sees, in order."""
        return self._native.observations

    @property
    def commands(self):
        """Name, unit, lower and upper limit of each command, in order."""
        return self._native.commands

    @property
    def time_step(self):
        """Time between two commands, s."""
        return self._native.time_step

    def state_dict(self):
        """Every tensor of the policy as a numpy array, by its name in `policy.safetensors`: weights, what it subtracts from
        observations and divides them by, design, log standard deviations."""
        return self._native.state_dict()

    def layers(self):
        """The controller's layers: weight `(outputs, inputs)`, bias `(outputs,)`, and what follows (`"tanh"`, `"relu"`, `"identity"`)."""
        return self._native.layers()

    def to_torch(self):
        """The same function as a `torch.nn.Module`, observations in SI to commands in SI, single precision."""
        import torch

        activations = {"tanh": torch.nn.Tanh, "relu": torch.nn.ReLU, "identity": torch.nn.Identity}
        center, scale, clip = self._native.normalizer()
        low = torch.tensor([port[2] for port in self.commands], dtype=torch.float32)
        high = torch.tensor([port[3] for port in self.commands], dtype=torch.float32)
        parts = []
        for weight, bias, activation in self.layers():
            linear = torch.nn.Linear(*reversed(weight.shape))
            with torch.no_grad():
                linear.weight.copy_(torch.from_numpy(weight.copy()))
                linear.bias.copy_(torch.from_numpy(bias.copy()))
            parts += [linear, activations[activation]()]
        network = torch.nn.Sequential(*parts)

        class Controller(torch.nn.Module):
            def __init__(self):
                super().__init__()
                self.network = network
                self.register_buffer("center", torch.from_numpy(center).float())
                self.register_buffer("scale", torch.from_numpy(scale).float())
                self.register_buffer("low", low)
                self.register_buffer("high", high)

            def forward(self, observation):
                seen = (observation - self.center) / self.scale
                if clip is not None:
                    seen = seen.clamp(-clip, clip)
                command = self.network(seen) * (0.5 * (self.high - self.low)) + 0.5 * (self.high + self.low)
                return command.clamp(self.low, self.high)

        return Controller()

    def __repr__(self):
        return repr(self._native)
