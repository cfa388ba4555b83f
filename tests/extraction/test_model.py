import numpy as np

from uvshear.extraction import Model
from uvshear.interferometer.primary_beam import AiryBeam


def test_a_model_attenuates_as_told():
    assert Model(smears=False).attenuation(0.7) is None
    assert Model().attenuation(0.7) is not None
    beam = AiryBeam.from_diameters(np.array([13.5]))
    assert Model(primary_beam=beam, smears=False).attenuation(0.7) is not None
