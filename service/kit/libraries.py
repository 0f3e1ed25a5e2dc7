"""Libraries that are loaded when a service first draws, prints, writes a table or calls out: a third of its memory."""

from typing import TYPE_CHECKING

from estimator.on_demand import ModuleOnDemand

if TYPE_CHECKING:
    import altair as alt
    import httpx
    import polars as pl
    import pypdf
    import typst
    import vl_convert
else:
    alt, pl = ModuleOnDemand("altair"), ModuleOnDemand("polars")
    httpx, pypdf = ModuleOnDemand("httpx"), ModuleOnDemand("pypdf")
    typst, vl_convert = ModuleOnDemand("typst"), ModuleOnDemand("vl_convert")

__all__ = ["alt", "httpx", "pl", "pypdf", "typst", "vl_convert"]
