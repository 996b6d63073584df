"""Errors as the panel shows them: parameters by the labels of their fields."""

from ..errors import InputError, in_words


def told(error: InputError) -> str:
    """Return an error's line with each parameter as its field in the panel is labeled."""
    return error.told(label)


def label(parameter: str) -> str:
    """Return the label of a parameter's field; its name in words where the panel has none."""
    from . import batch, material_properties, place, properties

    of_material = material_properties.SkylightReflectance
    groups = (properties.SkylightNumbers, of_material, batch.SkylightBatch)
    for group in (*groups, place.SkylightPlace):
        if (field := group.bl_rna.properties.get(parameter)) is not None:
            return field.name
    return in_words(parameter).title()
