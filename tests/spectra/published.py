"""Files of reflectances as their publishers write them, made here by what they publish."""

import json

import numpy as np

X = np.arange(350.0, 1001.0, 5.0)
RISING = 0.1 + 0.7 * (X - 350) / 650


FALLING = 0.9 - 0.7 * (X - 350) / 650


def splib07(folder, values=RISING, name="Brick GDS350 Dkred  ASDFRa AREF", wavelengths=X):
    """A spectrum of the USGS in its chapter, and the wavelengths above it."""
    chapter = folder / "ASCIIdata_splib07a" / "ChapterA_ArtificialMaterials"
    chapter.mkdir(parents=True, exist_ok=True)
    for kind, nm in (("ASD_0.35-2.5_microns", wavelengths), ("BECK_Beckman_0.2-3.0", X * 2)):
        rows = [f"   {x / 1000:.6f}" for x in nm]
        title = f" splib07a Record=1: Wavelengths {kind}"
        (chapter.parent / f"splib07a_Wavelengths_{kind}.txt").write_text("\n".join([title, *rows]))
    path = chapter / "splib07a_Brick_GDS350_Dkred_ASDFRa_AREF.txt"
    path.write_text("\n".join([f" splib07a Record=12: {name}", *(f" {v:.7e}" for v in values)]))
    return path


def envi(folder, spectra, names=("one", "two"), kind=4, order=0, factor=1.0, more="", nm=False):
    """A spectral library, wavelengths in µm."""
    path = folder / "urban.sli"
    kinds = {2: "i2", 4: "f4", 5: "f8"}
    data = (np.array(spectra) * factor).round(0 if kind == 2 else 12)
    path.write_bytes(data.astype("<>"[order] + kinds[kind]).tobytes())
    nm = X if nm else X / 1000
    path.with_suffix(".hdr").write_text(
        f"ENVI\ndescription = {{\n  Made by a test, for = signs}}\nsamples = {X.size}\n"
        f"lines   = {len(spectra)}\nbands   = 1\nheader offset = 0\n"
        f"file type = ENVI Spectral Library\ndata type = {kind}\ninterleave = bsq\n"
        f"byte order = {order}\nwavelength units = {'Nanometers' if nm is X else 'Micrometers'}\n"
        + (f"reflectance scale factor = {factor}\n" if factor else "")
        + f"spectra names = {{\n {', '.join(names)}}}\n"
        + f"wavelength = {{\n {', '.join(f'{x:.6f}' for x in nm)}}}\n{more}"
    )
    return path


def ecostress(folder, values=RISING, y="Reflectance (percent)", scale=100.0):
    """A spectrum that descends from the infrared, as those of JHU do."""
    rows = [f"{x / 1000:.4f}\t{scale * v:.4f}" for x, v in zip(X[::-1], values[::-1], strict=True)]
    path = folder / "manmade.road.asphalt.solid.all.0095uuuasp.jhu.becknic.spectrum.txt"
    head = (
        "Name: Construction Asphalt\nType: manmade\nClass: Road\nSubclass: none\n"
        "Sample No.: 0095UUUASP\nOwner: JHU\nDescription: Dark: and tarry.\nOn two lines.\n"
        f"X Units: Wavelength (micrometers)\nY Units:{y}\nFirst X Value: 1.0\nLast X Value:  0.35\n"
        f"Number of X Values: {len(rows)}\nAdditional Information: none\n\n"
    )
    path.write_text(head + "\n".join(["14.0000\t 999.0", "2.0800\t 5.0", "2.0800\t 6.0", *rows]))
    return path


def igsdb(folder, values=RISING):
    """A product with wavelengths in µm to the far infrared, and one null."""
    rows = [
        {"wavelength": x / 1000, "T": v, "Rf": 0.1, "Rb": 0.2}
        for x, v in zip(X, values, strict=True)
    ]
    rows += [{"wavelength": 55.556, "T": None, "Rf": 0.5, "Rb": 0.5}]
    path = folder / "product_1.json"
    product = {"name": "Green 60%T", "spectral_data": {"spectral_data": rows}}
    path.write_text(json.dumps(product), encoding="utf-8")
    return path


def matlab(folder, saved=None, **variables):
    from scipy.io import savemat

    path = folder / "sur_house.mat"
    savemat(path, variables, **(saved or {}))
    return path


def psychtoolbox(folder, values=RISING, labels=False, **saved):
    padded = np.zeros((X.size + 4, 2))
    padded[2:-2] = np.column_stack([values, FALLING])
    grid = np.array([[X[0] - 10, 5, X.size + 4]], dtype=np.uint16)
    more = {"labels_house": np.array(["roof", "Öl"], dtype=object)} if labels else {}
    return matlab(folder, saved, sur_house=padded, S_house=grid, note="text", **more)


def isetcam(folder, values=RISING):
    data = np.column_stack([values, FALLING])
    return matlab(folder, data=data, wavelength=X[:, None], comment="cloth")


def cgats(folder, field="SPECTRAL_NM_{:.0f}", scale=1.0, more="", values=RISING, name="wall.txt"):
    fields = " ".join(["SAMPLE_ID", "SAMPLE_NAME", "LAB_L", *(field.format(x) for x in X)])
    rows = [
        f'{k} "{title}" 50.0 ' + " ".join(f"{scale * v:.8f}" for v in curve)
        for k, (title, curve) in enumerate((("dark red", values), ("white", FALLING)), 1)
    ]
    path = folder / name
    path.write_text(
        f'CGATS.17\nORIGINATOR "a test"\n{more}NUMBER_OF_FIELDS {X.size + 3}\n'
        f"BEGIN_DATA_FORMAT\n{fields}\nEND_DATA_FORMAT\nNUMBER_OF_SETS 2\nBEGIN_DATA\n"
        + "\n".join(rows)
        + "\nEND_DATA\n"
    )
    return path


def cxf(folder, values=RISING, start="", head=""):
    numbers = " ".join(f"{v:.8f}" for v in values)
    path = folder / "wall.cxf"
    path.write_text(
        f'<?xml version="1.0" encoding="UTF-8"?>{head}\n'
        '<cc:CxF xmlns:cc="http://colorexchangeformat.com/CxF3-core"><cc:Resources>'
        '<cc:ObjectCollection><cc:Object ObjectType="Standard" Name="Blå" Id="1"><cc:ColorValues>'
        f'<cc:ReflectanceSpectrum ColorSpecification="M1"{start}>{numbers}'
        "</cc:ReflectanceSpectrum></cc:ColorValues></cc:Object>"
        '<cc:Object ObjectType="Standard" Name="Lab" Id="2"><cc:ColorValues><cc:ColorCIELab>'
        "<cc:L>50</cc:L></cc:ColorCIELab></cc:ColorValues></cc:Object></cc:ObjectCollection>"
        '<cc:ColorSpecificationCollection><cc:ColorSpecification Id="M1"><cc:MeasurementSpec>'
        '<cc:WavelengthRange StartWL="350" Increment="5"/></cc:MeasurementSpec>'
        "</cc:ColorSpecification></cc:ColorSpecificationCollection></cc:Resources></cc:CxF>",
        encoding="utf-8",
    )
    return path


PUBLISHED = {
    "USGS ASCII": (splib07, "Brick GDS350 Dkred ASDFRa AREF", "Artificial Materials"),
    "ECOSTRESS": (ecostress, "Construction Asphalt 0095UUUASP", "manmade, Road"),
    "IGSDB": (igsdb, "Green 60%T transmittance", "glazing, transmittance"),
    "Psychtoolbox": (psychtoolbox, "house 1", None),
    "Psychtoolbox, packed, with labels": (
        lambda f, **o: psychtoolbox(f, labels=True, do_compression=True, **o),
        "roof",
        None,
    ),
    "Psychtoolbox, version 4": (lambda f, **o: psychtoolbox(f, format="4", **o), "house 1", None),
    "ISETCam": (isetcam, "sur_house 1", None),
    "CGATS": (cgats, "dark red", None),
    "CGATS of i1Profiler": (lambda f, **o: cgats(f, "nm{:.0f}", **o), "dark red", None),
    "CGATS of Argyll": (
        lambda f, **o: cgats(f, "SPEC_{:.0f}", 100.0, 'SPECTRAL_NORM "100.000"\n', **o),
        "dark red",
        None,
    ),
    "CxF3": (cxf, "Blå", "Standard"),
    "CxF3, range at the spectrum": (
        lambda f, **o: cxf(f, start=' StartWL="350"', **o),
        "Blå",
        None,
    ),
}


def two(folder):
    return envi(folder, [RISING, FALLING])
