"""Runs the notebooks and writes them as pages: `python sim/python/examples/notebooks.py [NAME ...]`, from the repository's root.

A notebook's source is a Python file here, its cells apart by `# %%` and `# %% [markdown]`, so that it can be read, compared and run as a program.
It is executed with its folder as working directory; the page, docs/results/notebooks/NAME.md, shows cells and what came of them. Needs `pip install nbclient nbconvert ipykernel matplotlib`.
"""

import re
import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbconvert import MarkdownExporter

HERE = Path(__file__).resolve().parent
PAGES = HERE.parents[2] / "docs" / "results" / "notebooks"


def cells(text):
    for part in re.split(r"^# %%", text, flags=re.M)[1:]:
        head, _, body = part.partition("\n")
        if "[markdown]" in head:
            yield nbformat.v4.new_markdown_cell(re.sub(r"^# ?", "", body.strip(), flags=re.M))
        else:
            yield nbformat.v4.new_code_cell(body.strip())


def run(source):
    notebook = nbformat.v4.new_notebook(cells=list(cells(source.read_text())))
    # Numbers instead of random names, so that the same notebook is the same file.
    for number, cell in enumerate(notebook.cells):
        cell["id"] = f"cell-{number}"
    NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(source.parent)}}).execute()
    for cell in notebook.cells:
        cell.metadata.clear()
        if cell.cell_type == "code":
            # Logs belong to the run and not to the page; a table is read as text.
            cell.outputs = [output for output in cell.outputs if output.get("name") != "stderr"]
            for output in cell.outputs:
                output.get("data", {}).pop("text/html", None)
            printed = [output for output in cell.outputs if output.output_type == "stream"]
            for more in printed[1:]:
                printed[0].text += more.text
                cell.outputs.remove(more)
    page, resources = MarkdownExporter().from_notebook_node(notebook, {"output_files_dir": source.stem, "unique_key": source.stem})
    PAGES.mkdir(parents=True, exist_ok=True)
    for name, data in resources["outputs"].items():
        (PAGES / name).parent.mkdir(exist_ok=True)
        (PAGES / name).write_bytes(data)
    tidy = "\n".join(line.rstrip() for line in page.strip().splitlines())
    (PAGES / f"{source.stem}.md").write_text(f"{tidy}\n\n*Run by `python sim/python/examples/notebooks.py {source.stem}`.*\n")
    print(source.stem)


def main():
    # What has no cells is a module of theirs.
    sources = (path for path in (HERE / "notebooks").glob("*.py") if path.read_text().startswith("# %%"))
    chosen = sys.argv[1:] or sorted(path.stem for path in sources)
    for name in chosen:
        run(HERE / "notebooks" / f"{name}.py")


if __name__ == "__main__":
    main()
