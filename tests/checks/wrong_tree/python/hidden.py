"""A class whose second method hides the first."""


class Hidden:
    def test(self):
        return 1

    def test(self):
        return 2
