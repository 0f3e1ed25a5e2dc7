"""How a table of one's own layout is read, before anything is stored."""

from typing import Any

from pydantic import BaseModel, Field

from service.api.schemas.problem import Fault


class LayoutColumn(BaseModel):
    """One column as it stands in the file."""

    heading: str = Field(description="As it stands, joined where there are two rows of headings.")
    cells: list[str] = Field(description="The first ones.")
    numeric: bool = Field(description="Whether most of its cells are numbers.")
    empty: bool = Field(description="Whether no cell says anything.")
    words: list[str] = Field(description="The different texts of a column with few of them.")


class PreviewSchema(BaseModel):
    """A table under a mapping; correct the mapping and send it again, or with the file to `POST /sessions`."""

    mapping: dict[str, Any] = Field(description="imu-mapping/1, complete as it is to be sent.")
    remembered: bool = Field(description="Whether it is that of an earlier file with the same headings.")
    fingerprint: str = Field(description="SHA-256 of the headings.")
    rows: int = Field(description="Of the file.")
    sheets: list[str] = Field(description="Of a workbook.")
    columns: list[LayoutColumn] = Field(description="Of the file, in its order.")
    problems: list[Fault] = Field(description="What is missing or cannot be read yet; empty when it can be stored.")
    first_rows: list[dict[str, float | str]] = Field(
        description="As they will be read, SI: angles in rad, sensors in m/s² or rad/s."
    )
    felt: float | None = Field(
        description="Length of the first row's vector by the nominal axes: about 9.8 m/s² at rest."
    )
