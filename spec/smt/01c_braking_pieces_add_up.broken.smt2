; BROKEN     Twin of 01c_braking_pieces_add_up.smt2: the robot speeds up between the pieces.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const v Real)        ; speed of the robot
(declare-const v1 Real)       ; speed after the first piece
(declare-const v2 Real)       ; speed after the second
(declare-const t Real)        ; time of the first
(declare-const x Real)        ; way of the first
(declare-const t2 Real)       ; time of the second
(declare-const x2 Real)       ; way of the second
(declare-const vm Real)       ; speed at which the second begins
; Assumptions
(assert (> b 0))
(assert (>= v 0))
(assert (>= v1 0))
(assert (>= v2 0))
(assert (>= vm 0))
(assert (>= vm v1))                                          ; BROKEN: faster than the first piece left it
(assert (<= (* b t) (- v v1)))
(assert (<= (* 2 b x) (- (* v v) (* v1 v1))))
(assert (<= (* b t2) (- vm v2)))
(assert (<= (* 2 b x2) (- (* vm vm) (* v2 v2))))

; Conclusion, negated
(assert (not (and (<= (* b (+ t t2)) (- v v2)) (<= (* 2 b (+ x x2)) (- (* v v) (* v2 v2))))))
(check-sat)
