"""Makes the files beside it with other people's writers, for the tests of the readers.

    pip install numpy laspy lazrs nibabel SimpleITK vtk && python make.py

Volumes have 3 x 4 x 5 voxels of the value 100 x + 10 y + z and spacings 0.5, 1, 2. Clouds have 12 points at (k mod 4, k / 4, k / 2)
with the colours (1000 k, 65535 - 1000 k, 500 k), scaled by 0.001 around (500000, 4500000, 100).

Not by others: compressed.ply, first.sog, second.sog, streams.spz and tiny.glb are the few Gaussians of the unit tests of those readers,
kept as files so that the mutation suite can damage them. So are level0.ksplat to level2.ksplat, which the end of this file writes: most of
such a file is padding, and fifty Gaussians leave something to damage.
"""

import struct

import laspy
import nibabel
import numpy as np
import SimpleITK as sitk
import vtk
from vtk.util.numpy_support import numpy_to_vtk

x, y, z = np.meshgrid(range(3), range(4), range(5), indexing="ij")
volume = (100 * x + 10 * y + z).astype(np.int16)
spacings = [0.5, 1.0, 2.0]

for name, image in [("volume.nii", nibabel.Nifti1Image), ("volume.nii.gz", nibabel.Nifti1Image), ("second.nii", nibabel.Nifti2Image)]:
    nibabel.save(image(volume, np.diag(spacings + [1.0])), name)
scaled = nibabel.Nifti1Image(volume / 7.0, np.diag(spacings + [1.0]))
scaled.set_data_dtype(np.int16)
nibabel.save(scaled, "scaled.nii")
big = nibabel.Nifti1Image(volume, np.diag(spacings + [1.0])).header.as_byteswapped(">")
nibabel.save(nibabel.Nifti1Image(volume, np.diag(spacings + [1.0]), big), "big.nii")

image = sitk.GetImageFromArray(np.ascontiguousarray(volume.T))
image.SetSpacing(spacings)
sitk.WriteImage(image, "volume.mha")
sitk.WriteImage(image, "packed.mha", useCompression=True)
sitk.WriteImage(sitk.Cast(image, sitk.sitkFloat32), "volume.mhd")

grid = vtk.vtkImageData()
grid.SetDimensions(3, 4, 5)
grid.SetSpacing(*spacings)
array = numpy_to_vtk(volume.flatten(order="F"), deep=True)
array.SetName("value")
grid.GetPointData().SetScalars(array)
for name, mode, compressor, encoded in [
    ("ascii.vti", "Ascii", None, True),
    ("binary.vti", "Binary", None, True),
    ("packed.vti", "Binary", "ZLib", True),
    ("appended.vti", "Appended", None, True),
    ("raw.vti", "Appended", "ZLib", False),
]:
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetFileName(name)
    writer.SetInputData(grid)
    getattr(writer, f"SetDataModeTo{mode}")()
    writer.SetCompressorTypeToZLib() if compressor else writer.SetCompressorTypeToNone()
    writer.SetEncodeAppendedData(encoded)
    writer.SetBlockSize(32)
    writer.Write()
writer = vtk.vtkXMLImageDataWriter()
writer.SetFileName("wide.vti")
writer.SetInputData(grid)
writer.SetHeaderTypeToUInt64()
writer.SetByteOrderToBigEndian()
writer.SetBlockSize(32)
writer.Write()

sphere = vtk.vtkSphereSource()
sphere.SetThetaResolution(6)
sphere.SetPhiResolution(5)
sphere.SetRadius(2.0)
writer = vtk.vtkOBJWriter()
writer.SetFileName("sphere.obj")
writer.SetInputConnection(sphere.GetOutputPort())
writer.Write()

k = np.arange(12)
for version, form, names in [("1.2", 2, ["old.las", "old.laz"]), ("1.4", 7, ["new.las", "new.laz"])]:
    header = laspy.LasHeader(version=version, point_format=form)
    header.scales, header.offsets = [0.001] * 3, [500000.0, 4500000.0, 100.0]
    cloud = laspy.LasData(header)
    cloud.x, cloud.y, cloud.z = 500000 + k % 4, 4500000 + k // 4, 100 + k / 2
    cloud.red, cloud.green, cloud.blue = 1000 * k, 65535 - 1000 * k, 500 * k
    for name in names:
        cloud.write(name, laz_backend=laspy.LazBackend.Lazrs)


def ksplat(level, count, degree):
    """Three full buckets of sixteen Gaussians and a partial one, by the format's description; numbers from a fixed seed."""
    rng = np.random.default_rng(level)
    centres = rng.uniform(-1, 1, (count, 3))
    scales, turns = rng.uniform(0.05, 0.4, (count, 3)), rng.normal(size=(count, 4))
    colours = rng.integers(0, 256, (count, 4), dtype=np.uint8)
    rest = rng.uniform(-0.4, 0.4, (count, 3 * ((degree + 1) ** 2 - 1)))
    size, full = 16, count // 16
    buckets = -(-count // size)
    header = bytearray(4096)
    struct.pack_into("<BB2xII4xIH14xff", header, 0, 0, 1, 1, 1, count, level, -1.5, 1.5)
    section = bytearray(1024)
    struct.pack_into("<IIIIfHxxIII", section, 0, count, count, size, buckets, 4.0, 12, 32767, 0, full)
    struct.pack_into("<IH", section, 36, buckets - full, degree)
    middles = np.array([centres[b * size : (b + 1) * size].mean(axis=0) for b in range(buckets)])
    data = struct.pack(f"<{buckets - full}I", *[count - full * size] * (buckets - full)) + middles.astype("<f4").tobytes()
    for k in range(count):
        parts = np.concatenate([scales[k], turns[k]])
        if level == 0:
            data += centres[k].astype("<f4").tobytes() + parts.astype("<f4").tobytes()
        else:
            steps = (centres[k] - middles[k // size]) / 2.0 * 32767 + 32767
            data += np.clip(steps.round(), 0, 65535).astype("<u2").tobytes() + parts.astype("<f2").tobytes()
        data += colours[k].tobytes()
        if level == 2:
            data += ((rest[k] + 1.5) / 3 * 255).round().astype(np.uint8).tobytes()
        else:
            data += rest[k].astype("<f2" if level else "<f4").tobytes()
    return bytes(header) + bytes(section) + data


for level in range(3):
    with open(f"level{level}.ksplat", "wb") as file:
        file.write(ksplat(level, 50, 1))
