; BROKEN     Twin of 01b_braking_way_and_time.smt2: the brakes are weaker than b instead of
;            stronger.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const beta Real)     ; actual braking
(declare-const v Real)        ; speed of the robot
(declare-const v1 Real)       ; speed afterwards
(declare-const t Real)        ; time that passes
(declare-const x Real)        ; robot's own way meanwhile
; Assumptions
(assert (> b 0))
(assert (>= v 0))
(assert (>= v1 0))
(assert (>= t 0))
(assert (and (> beta 0) (<= beta b)))                        ; BROKEN: turned round
(assert (= v1 (- v (* beta t))))
(assert (= x (- (* v t) (/ (* beta t t) 2))))

; Conclusion, negated
(assert (not (and (<= (* b t) (- v v1)) (<= (* 2 b x) (- (* v v) (* v1 v1))))))
(check-sat)
