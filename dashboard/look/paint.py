"""Colours of Bokeh models that follow the theme."""

from bokeh.model import Model

from railjoule.dashboard.look.tokens import COST_SCALES, SAVING_SCALES, THEMES, ThemeName, Tokens


class Palette:
    """The colours in use, and the models that wear them."""

    def __init__(self, dark: bool) -> None:
        self._worn: list[tuple[Model, str, str]] = []
        self.tokens: Tokens = {}
        self.costs: tuple[str, ...] = ()
        self.savings: tuple[str, ...] = ()
        self._choose(dark)

    @property
    def worn(self) -> tuple[tuple[Model, str, str], ...]:
        """Which attribute of which model has the colour of which token."""
        return tuple(self._worn)

    def _choose(self, dark: bool) -> None:
        theme: ThemeName = "dark" if dark else "light"
        self.tokens, self.costs, self.savings = THEMES[theme], COST_SCALES[theme], SAVING_SCALES[theme]

    def paint(self, model: Model, **attributes: str) -> None:
        """Give attributes of a model the colours of tokens, now and after each change of theme."""
        for attribute, token in attributes.items():
            setattr(model, attribute, self.tokens[token])
            self._worn.append((model, attribute, token))

    def switch(self, dark: bool) -> None:
        """Change the theme of all painted models."""
        self._choose(dark)
        for model, attribute, token in self._worn:
            setattr(model, attribute, self.tokens[token])
