"""The car of the paper's Table 1 as a vehicle file has it, for files to spoil."""

CAR = """[vehicle]
name = "car"
[parameters]
m_s = 1380
I_yy = 2440
I_xx = 380
m_uf = 40.5
m_ur = 45.4
k_sf = 17000
k_sr = 22000
k_tf = 192000
k_tr = 192000
c_sf = 1500
c_sr = 1500
a = 1.25
b = 1.51
t_f = 0.74
t_r = 0.74
"""
