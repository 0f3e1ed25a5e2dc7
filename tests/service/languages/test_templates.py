"""The words of templates, found without a mark."""

import pytest
from jinja2 import Environment

from service.languages.entry import MessageEntry
from service.languages.template import Template
from service.languages.templates import in_language, literals


def found(source: str) -> list[str | tuple[str, str]]:
    return [one.message.id for one in Template(source).messages()]


@pytest.mark.parametrize(
    ("source", "messages"),
    [
        ("<h1>Flags</h1>", ["Flags"]),
        ("<p>By {{ page.who }},\n  twice.</p>", ["By {who}, twice."]),
        ('<p>Read <a href="/x?a={{ b }}">it</a> now.</p>', ["Read <a>it</a> now."]),
        ("<p>{% if a %}One.{% else %}Two.{% endif %}</p>", ["One.", "Two."]),
        ('<p><a href="/">One</a> <a href="/b">Two</a></p>', ["One", "Two"]),
        ('<p>{{ n }} unit{{ "" if n == 1 else "s" }} here.</p>', [("{n} unit here.", "{n} units here.")]),
        ('<input placeholder="what for" value="not said">', ["what for"]),
        ("<p>Call <code>imu-health serve</code>.</p>", ["Call {code}."]),
        ("<script>say('nothing')</script><style>a { b: c }</style>", []),
        ('<p lang="en">English <b>everywhere</b>.</p><p>Not this.</p>', ["Not this."]),
    ],
)
def test_messages_of_a_template(source: str, messages: list[str | tuple[str, str]]) -> None:
    assert found(source) == messages


def test_words_inside_of_expressions() -> None:
    assert list(literals(Template('<p>{{ "before" if early else "after" }}</p><p class="{{ "wide" }}">'))) == [
        "before",
        "after",
    ]


def rendered(source: str, said: dict[str, list[str]], **values: object) -> str:
    environment = Environment(autoescape=True)
    environment.filters.update(translated=lambda value: f"[{value}]", plural_form=lambda n: min(n - 1, 2))

    def forms(message: MessageEntry) -> list[str]:
        return said.get(message.text, [])

    return environment.from_string(in_language(source, forms)).render(**values)


def test_places_and_tags_may_change_their_order() -> None:
    page = rendered('<p>{{ x }} of <b class="x">{{ y }}</b></p>', {"{x} of <b>{y}</b>": ["<b>{y}</b>: {x}"]}, x=1, y=2)
    assert page == '<p><b class="x">[2]</b>: [1]</p>'


@pytest.mark.parametrize(("n", "form"), [(1, "один"), (2, "два"), (3, "много")])
def test_a_number_chooses_the_form(n: int, form: str) -> None:
    source = '<p>{{ n }} thing{{ "" if n == 1 else "s" }}</p>'
    assert rendered(source, {"{n} thing": ["один", "два", "много"]}, n=n) == f"<p>{form}</p>"


def test_values_of_attributes_that_machines_read_are_left_alone() -> None:
    assert rendered('<p class="{{ a }}" title="{{ a }}">{{ a }}</p>', {}, a="pass") == (
        '<p class="pass" title="[pass]">[pass]</p>'
    )


def test_what_people_named_is_left_alone() -> None:
    assert rendered("<p>{{ unit.serial }} {{ note }}</p>", {}, unit={"serial": "none"}, note="fit") == "<p>none fit</p>"
