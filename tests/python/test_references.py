"""The reference results inside the FMUs (FMI-LS-REF), by which users check an import: read and repeated by FMPy alone."""

import pathlib
import posixpath
import zipfile

import fmpy
import fmpy.util
import numpy
import pytest
from conftest import MODELS, VERSIONS
from lxml import etree

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
NAMESPACE = "http://fmi-standard.org/fmi-ls-manifest"
ATTRIBUTES = ("fmi-ls-name", "fmi-ls-version", "fmi-ls-description")


class Reference:
    """What an FMU holds: times and tolerance of the experiment, inputs, results."""

    def __init__(self, path, folder):
        with zipfile.ZipFile(path) as archive:
            self.names = archive.namelist()
            self.manifest = etree.fromstring(archive.read(f"{FOLDER}/fmi-ls-manifest.xml"))
            (file,) = [one.get("source") for one in self.manifest if one.get("role").startswith("experiment")]
            (experiment,) = etree.fromstring(archive.read(f"{FOLDER}/{file}"))
            run = experiment.find("TransientSimulation")
            self.start, self.stop, self.step = (float(run.get(name)) for name in ("startTime", "stopTime", "stepSize"))
            self.tolerance = float(experiment.get("tolerance"))
            tables = []
            for element in ("Stimuli", "References"):
                table = pathlib.Path(folder) / f"{element}.csv"
                table.write_bytes(archive.read(f"{FOLDER}/{experiment.find(element).get('source')}"))
                tables.append(fmpy.util.read_csv(table))
            self.inputs, self.results = tables

    def repeat(self, path, step, **options):
        return fmpy.simulate_fmu(
            str(path), start_time=self.start, stop_time=self.stop, output_interval=step, input=self.inputs,
            output=list(self.results.dtype.names[1:]), **options,
        )

    def furthest(self, found, name):
        """Largest difference at the times that both have; at an event, of the values before it."""
        times = self.results["time"]
        places = numpy.searchsorted(found["time"], times - 1e-9)
        places = numpy.minimum(places, len(found) - 1)
        common = numpy.abs(found["time"][places] - times) < 1e-9
        assert common.sum() > 10
        difference = numpy.abs(found[name][places].astype(float) - self.results[name])
        return difference[common].max()


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("model", MODELS)
def test_co_simulation_gives_the_results(fmus, model, version, tmp_path):
    path = fmus[model, version]
    reference = Reference(path, tmp_path)
    found = reference.repeat(path, reference.step)
    for name in reference.results.dtype.names[1:]:
        largest = numpy.abs(reference.results[name]).max()
        assert reference.furthest(found, name) <= 1e-11 * largest, name


def test_a_longer_step_gives_them_too(reduced_rig, tmp_path):
    reference = Reference(reduced_rig, tmp_path)
    found = reference.repeat(reduced_rig, 8 * reference.step)
    assert reference.furthest(found, "theta") <= 1e-11 * reference.results["theta"].max()


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("model", ["SpeedController", "SoftTorque"])
def test_model_exchange_of_controllers_gives_them(fmus, model, version, tmp_path):
    path = fmus[model, version]
    reference = Reference(path, tmp_path)
    found = reference.repeat(path, reference.step, fmi_type="ModelExchange", solver="CVode", relative_tolerance=1e-10)
    assert reference.furthest(found, "u") < 1e-7


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("model", ["ReducedRig", "FullRig"])
def test_model_exchange_gives_them_within_the_solver_s_tolerance(fmus, model, version, tmp_path):
    path = fmus[model, version]
    reference = Reference(path, tmp_path)
    found = reference.repeat(path, reference.step, fmi_type="ModelExchange", solver="CVode",
                             relative_tolerance=reference.tolerance)
    for name in ("theta", "theta3"):
        assert reference.furthest(found, name) < 1e-6, name


def test_the_results_are_of_these_inputs(reduced_rig, tmp_path):
    reference = Reference(reduced_rig, tmp_path)
    reference.inputs["N2"] *= 1.001
    found = reference.repeat(reduced_rig, reference.step)
    assert reference.furthest(found, "theta") > 1e-4


def test_the_manifest_says_what_every_layered_standard_must(each_fmu, tmp_path):
    reference = Reference(each_fmu, tmp_path)
    attributes = pathlib.Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3LayeredStandardManifest.xsd"
    needed = "".join(f'<xs:attribute ref="ls:{name}" use="required"/>' for name in ATTRIBUTES)
    schema = etree.XMLSchema(etree.fromstring(
        f'<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema" xmlns:ls="{NAMESPACE}">'
        f'<xs:import namespace="{NAMESPACE}" schemaLocation="{attributes.as_uri()}"/>'
        '<xs:element name="fmiReferences"><xs:complexType><xs:sequence>'
        '<xs:any processContents="skip" minOccurs="0" maxOccurs="unbounded"/></xs:sequence>'
        f"{needed}</xs:complexType></xs:element></xs:schema>"
    ))
    schema.assertValid(reference.manifest)
    assert reference.manifest.get(f"{{{NAMESPACE}}}fmi-ls-name") == FOLDER.removeprefix("extra/")
    for related in reference.manifest:
        assert posixpath.normpath(f"{FOLDER}/{related.get('source')}") in reference.names
