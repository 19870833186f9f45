"""Tables of HTML for notebooks."""

from __future__ import annotations

Table = list[list[str]]  # the first row is the head


def html(caption: str, rows: Table) -> str:
    """A table of HTML; what is written in it is text, whatever it holds."""
    import html as escaping  # for notebooks alone

    head, *body = [[escaping.escape(cell) for cell in row] for row in rows]
    lines = ["<table>"]
    lines += [f"<caption>{escaping.escape(caption)}</caption>"] if caption else []
    lines.append("<thead><tr>" + "".join(f"<th>{cell}</th>" for cell in head) + "</tr></thead>")
    lines.append("<tbody>")
    lines += ["<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in body]
    return "\n".join([*lines, "</tbody>", "</table>"])
