"""What each picture of a result shows."""

from sprung.report.pictures.amplitudes import amplitude_pictures
from sprung.report.pictures.channels import channels_picture
from sprung.report.pictures.motions import motion_picture
from sprung.report.pictures.parameters import half_width, limits_percent, parameters_picture
from sprung.report.pictures.recordings import landing_picture, recording_picture
from sprung.report.pictures.spectra import spectra_picture
from sprung.report.pictures.stability import stability_picture

__all__ = [
    "amplitude_pictures",
    "channels_picture",
    "half_width",
    "landing_picture",
    "limits_percent",
    "motion_picture",
    "parameters_picture",
    "recording_picture",
    "spectra_picture",
    "stability_picture",
]
