"""An observer that writes down what it hears."""

from uvshear.progress import Observer


class Heard(Observer):
    """Writes down what it hears."""

    def __init__(self):
        self.all = []

    def begin(self, stage, *then):
        self.all.append(("begin", stage.name, tuple(each.name for each in then)))

    def advance(self, done, expected):
        self.all.append(("advance", done, expected))

    def foresee(self, *then):
        self.all.append(("foresee", *(each.name for each in then)))

    def note(self, facts):
        self.all.append(("note", dict(facts)))

    def finish(self):
        self.all.append(("finish",))

    @property
    def stages(self):
        return [what[1] for what in self.all if what[0] == "begin"]
