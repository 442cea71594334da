// error: illuminate belongs into a light shader
surface wrong_kind_of_light() { illuminate (P) Ci = 1; }
