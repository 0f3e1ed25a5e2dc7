"""A sentence is stored with its parts, so that it can be said in any language when it is read."""

from collections.abc import Iterator

import pytest
from sqlalchemy import Column, Connection, Integer, MetaData, Table, create_engine, select, text

from estimator.message import Message, joined, say, say_count
from service.languages.catalogue import catalogue_of
from service.languages.language import Language
from service.storage.columns import PARTS, Sentence, is_made_of
from service.storage.json_text import STORED

KEPT = Table("kept", MetaData(), Column("id", Integer, primary_key=True), Column("said", Sentence))
GONE = "The units measured on {stand} no longer show a shift."


@pytest.fixture
def connection() -> Iterator[Connection]:
    engine = create_engine("sqlite://")
    KEPT.metadata.create_all(engine)
    with engine.connect() as connection:
        yield connection
    engine.dispose()


def kept(connection: Connection, said: str) -> str:
    """Written and read."""
    connection.execute(KEPT.insert().values(said=said))
    return str(connection.scalars(select(KEPT.c.said)).one())


@pytest.mark.parametrize("said", [say(GONE, stand="ODG-1"), say_count("{n} row", "{n} rows", 3), say("Fit")])
def test_a_message_read_from_a_column_says_the_same_in_russian(connection: Connection, said: Message) -> None:
    read, russian = kept(connection, said), catalogue_of(Language.RUSSIAN)
    assert read == said
    assert russian.say(read) == russian.say(said)
    assert russian.say(read) != said


def test_a_message_read_from_a_document_says_the_same_in_russian() -> None:
    said, russian = say(GONE, stand="ODG-1"), catalogue_of(Language.RUSSIAN)
    assert russian.say(STORED.read(str, STORED.written(said))) == russian.say(said)


@pytest.mark.parametrize("said", ["Plain.", "", '{"message":"{x}","parts":{"x":"Fit"}}', '{"message":', "{}", "a\x1fb"])
def test_a_plain_text_is_read_as_it_was_written(connection: Connection, said: str) -> None:
    assert kept(connection, said) == said


@pytest.mark.parametrize("said", [say(GONE, stand="ODG-1"), joined("; ", [])])
def test_who_reads_the_database_finds_the_english_first(connection: Connection, said: Message) -> None:
    connection.execute(KEPT.insert().values(said=said))
    raw: str = connection.scalars(text("SELECT said FROM kept")).one()
    assert raw.partition(PARTS)[0] == said


def test_a_sentence_of_an_older_release_is_shown_as_it_was_stored(connection: Connection) -> None:
    older = "The units measured on ODG-1 no longer show that it has shifted."
    connection.execute(text("INSERT INTO kept (said) VALUES (:said)"), {"said": older})
    read = connection.scalars(select(KEPT.c.said)).one()
    assert catalogue_of(Language.RUSSIAN).say(str(read)) == older


@pytest.mark.parametrize(
    ("said", "expected"),
    [(say(GONE, stand="a_%"), True), ("The units measured on ODG-1 no longer", True), (say("The units"), False)],
)
def test_rows_are_found_by_the_template_of_their_sentence(connection: Connection, said: str, expected: bool) -> None:
    connection.execute(KEPT.insert().values(said=said))
    assert connection.scalar(select(is_made_of(KEPT.c.said, GONE))) == expected
