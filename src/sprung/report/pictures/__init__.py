"""What each picture of a result shows."""

from sprung.report.pictures.amplitudes import amplitude_pictures
from sprung.report.pictures.channels import channels_picture
from sprung.report.pictures.motions import motion_picture
from sprung.report.pictures.parameters import half_width, limits_percent, parameters_picture
from sprung.report.pictures.recordings import near_picture, whole_picture
from sprung.report.pictures.spectra import spectra_picture
from sprung.report.pictures.stability import stability_picture

__all__ = [
    "amplitude_pictures",
    "channels_picture",
    "half_width",
    "limits_percent",
    "motion_picture",
    "near_picture",
    "parameters_picture",
    "spectra_picture",
    "stability_picture",
    "whole_picture",
]
