"""The reader of traces, by which power cuts are tried: a call is the same whether strace wrote it at once or halved."""

from tests.service.storage.disk import Call, calls

WRITTEN = Call("pwrite64", "/d/wal", b"ab", 24752, "")


def test_a_call_that_another_one_interrupted_writes_where_it_wrote() -> None:
    whole = '7 pwrite64(5</d/wal>, "\\x61\\x62", 2, 24752) = 2'
    halved = '7 pwrite64(5</d/wal>, "\\x61\\x62", 2, 24752 <unfinished ...>\n8 fsync(3</d>) = 0\n'
    resumed = "7 <... pwrite64 resumed>)     = 2"
    assert list(calls(whole, "/d")) == [WRITTEN]
    assert list(calls(halved + resumed, "/d")) == [Call("fsync", "/d"), WRITTEN]
