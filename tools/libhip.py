"""Where the surfaces of ../shared/data/libhip lie."""


def surface_path(folder, structure):
    """The structure's surface in one hip's folder (.../libhip/m2/left): the exact one, else the one fitted to it."""
    exact = folder / f"{structure}.ply"
    return exact if exact.exists() else folder / f"{structure}_fitted.ply"
