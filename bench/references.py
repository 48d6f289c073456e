"""The bibliography: every published number and formula in the bench points to a `Source`."""

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Source:
    """A publication, and the place in it.

    Attributes
    ----------
    key : str
        Short name, as it is cited in docstrings.
    citation : str
        Authors, title, where it was published.
    place : str
        Section, equation, table or page; empty for the whole work.
    """

    key: str
    citation: str
    place: str = ""

    def at(self, place: str) -> "Source":
        """Return the same publication, pointing to a place in it."""
        return replace(self, place=place)

    def __str__(self) -> str:
        return f"{self.citation}{', ' + self.place if self.place else ''}"


QIN = Source(
    "Qin",
    "Qin Fangjun, Xu Jiangning, Li An: A new calculative method for gyro-free inertial navigation system "
    "using 9 accelerometers, Geomatics and Information Science of Wuhan University",
)
CHEN = Source(
    "Chen",
    "Chen J.-H., Lee S.-C., DeBra D. B.: Gyroscope free strapdown inertial measurement unit by six linear "
    "accelerometers, J. Guidance, Control, and Dynamics 17(2), 1994",
)
TAN = Source(
    "Tan",
    "Tan C. W., Park S.: Design of accelerometer-based inertial navigation systems, "
    "IEEE Trans. Instrumentation and Measurement 54(6), 2005",
)
SKOG = Source(
    "Skog",
    "Skog I., Nilsson J.-O., Handel P., Nehorai A.: Inertial sensor arrays, maximum likelihood, and "
    "Cramer-Rao bound, IEEE Trans. Signal Processing 64(16), 2016",
)
XU = Source(
    "Xu",
    "Xu Zhihao, Zhou Zhaofa, Xu Zihao, Chang Zhenjun, Guo Qi: Performance analysis of high-precision strapdown "
    "inertial navigation attitude algorithms, Electronics Optics & Control 26(7), 25-28, 2019",
)
ZHAO = Source(
    "Zhao",
    "Zhao Lin, Li Jiushun, Cheng Jianhua: Double-filters external damping strapdown inertial navigation "
    "algorithm, J. Harbin Institute of Technology 50(3), 2018, doi:10.11918/j.issn.0367-6234.201612054",
)
LYU = Source(
    "Lyu",
    "Lyu Weiwei, Cheng Xianghong, Qiu Wei: Dual-Euler full-attitude method, Aerospace Shanghai 2019(1)",
)
WANG = Source(
    "Wang",
    "Wang Zhenhuan, Chen Xijun, Zeng Qingshuang: Rotation vector and dual quaternion strapdown algorithms in "
    "the inertial frame, Harbin Institute of Technology",
)
HG9900 = Source("HG9900", "Honeywell: HG9900 inertial measurement unit, brochure N61-1638-000-000")
HG1700 = Source("HG1700", "Honeywell: HG1700 inertial measurement unit, brochure N61-1619-000-001")
ADIS16495 = Source("ADIS16495", "Analog Devices: ADIS16495 data sheet, Rev. C, 2020")
